"""Read the files of a package without running them: Python, package.xml, setup.py and parameter files."""
