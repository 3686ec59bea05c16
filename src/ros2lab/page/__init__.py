"""The page of `ros2lab dashboard`: its server, what its kernel runs, and the template of the page.

voila serves the page: a notebook of one cell, run in a kernel of its own, of which only the output is shown.
"""
