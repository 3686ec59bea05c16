"""Import what is not there."""

import nowhere_at_all  # noqa: F401
