"""The commands: a package for one that has verbs, a module for one that has none; `_name` is a helper."""
