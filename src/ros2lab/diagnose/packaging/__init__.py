"""Rules over packages: manifests, setup files, entry points, the places of files, and what was installed."""
