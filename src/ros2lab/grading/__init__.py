"""Grade what a student hands in: receive, build, observe, judge, report."""
