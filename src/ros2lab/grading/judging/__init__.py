"""What was seen, held against what is asked for: who plays which part, and what follows a command."""
