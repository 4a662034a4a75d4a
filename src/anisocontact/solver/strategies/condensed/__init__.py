"""Static condensation (Schur complement) of linear bulk on the unknowns that can be touched."""
