"""A grade in the forms that people and machines read: a module for each, with a function from data to text.

A submission's own texts are shown so that they do nothing and hide nothing; see `shown`.
"""
