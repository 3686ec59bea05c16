"""Have no function that makes a description."""

WHAT = "nothing"
