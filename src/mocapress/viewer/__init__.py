"""The page that plays motion: as one file, from a server on this machine, in a notebook."""
