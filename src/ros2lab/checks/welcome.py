"""The exercise of `00_welcome`."""

from __future__ import annotations

from typing import Any

from ros2lab.checks import CheckError, Question, answer_of, exercise, quiz_of
from ros2lab.topics import TopicLog

QUIZ = (
    Question(
        "b",
        "Name and type of the topic are all that two nodes share.",
        {
            "a": "did you tell the log who speaks?",
            "c": "which of the two did you start first, and would the other order have been an error?",
        },
    ),
    Question(
        "c",
        "What is published while nobody listens is gone; week 3 shows how the last message can be kept.",
        {
            "a": "why did we make the log before we published?",
            "b": "a topic does not know who has heard what.",
        },
    ),
    Question(
        "a",
        "The session's thread serves the node, so that the notebook stays free.",
        {
            "b": "the node counted while you were reading.",
            "c": "who published the greetings that the log heard afterwards?",
        },
    ),
)


@exercise
def my_words(function: Any, log: TopicLog) -> str:
    """Check that `function` returns a sentence of at least three words, and that `log` heard it.

    Args:
        function: takes nothing, returns the sentence.
        log: a log of the topic on which the sentence was published (std_msgs/String).

    Raises:
        CheckError: if it does not, or was not heard.
    """
    words = answer_of(function, call="my_words()")
    if not isinstance(words, str):
        raise CheckError(
            "my_words() returns a text", repr(words), 'write return "..." with your sentence in quotes.'
        )
    if len(words.split()) < 3:
        raise CheckError("at least three words", repr(words), "what would a robot say?")
    if not any(sample.message.data == words for sample in log.samples()):
        raise CheckError(
            f"{words!r} on {log.topic}",
            f"{log.count} messages, and none of them says it",
            "publish it first: run the cell above the check.",
        )
    return f"Right: {log.topic} carried your words."


quiz = quiz_of(__name__, QUIZ)
