"""Fixes that are tried before they are suggested."""
