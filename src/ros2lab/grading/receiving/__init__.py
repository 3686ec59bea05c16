"""Take what was handed in: unpack it into a clean copy, and choose the package that is graded."""
