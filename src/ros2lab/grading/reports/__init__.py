"""What people and machines read of a grade: a module for each form, each with a function from data to text.

What a submission has written is shown so that it does nothing and hides nothing; see `shown`.
"""
