"""The facts of a submission's files, parsed in a box and never run or imported, and the plan of its build."""
