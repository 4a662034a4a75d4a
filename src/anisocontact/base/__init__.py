"""What every package uses: errors, the registry, arrays, processes, files written whole, limits."""
