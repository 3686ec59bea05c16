"""A whole class: found, graded side by side, kept in a gradebook, reported, and exported.

    found = discovery.find(folder, received)      # names and paths -> what was handed in, by whom
    outcome = one.graded_apart(...)               # one submission, in a process of its own -> evidence
    book.record(...)                              # evidence and grade, in one transaction

The gradebook is the only state: whatever is interrupted goes on from it. The judge is asked in one place, `one.seen`.
"""
