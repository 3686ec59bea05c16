"""What the files of a package say: its Python, its manifest, its setup and its parameter files, read and never run."""
