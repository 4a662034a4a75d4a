"""What every room uses: errors, the registry, arrays, processes, files written whole, limits."""
