"""What an event is."""


class Event:
    """Something that has happened while launching."""

    name = "launch.Event"
