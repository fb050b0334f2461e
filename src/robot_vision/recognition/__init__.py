"""Objects by their meshes: the database of them, training, and where they are in images."""
