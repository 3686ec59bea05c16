"""What a type checker says, and lines that are tried on copies."""
