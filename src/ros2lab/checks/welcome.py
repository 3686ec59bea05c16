"""The exercise of `00_welcome`."""

from __future__ import annotations

from typing import Any

from std_msgs.msg import String

from ros2lab.checks import CheckError, Prediction, Question, answer_of, exercise, predict_of, quiz_of
from ros2lab.session import LabSession
from ros2lab.topics import TopicLog, type_name

QUIZ = (
    Question(
        "Two nodes want to exchange messages. What must they agree on?",
        ("Each other's names.", "The topic's name and the message type.", "Which of them starts first."),
        "b",
        "The name and the type of the topic are all that two nodes share.",
        {
            "a": "did you tell the log who publishes?",
            "c": "which did you start first, and would the other order have been an error?",
        },
    ),
    Question(
        "You publish a message, and somebody subscribes a second later. Do they receive it?",
        (
            "Yes, the topic keeps it.",
            "Yes, if nobody else has received it.",
            "No, a topic delivers to those who have subscribed by then.",
        ),
        "c",
        "What is published while nobody has subscribed is gone; week 3 shows how the last message can be kept.",
        {
            "a": "why did we make the log before we published?",
            "b": "a topic does not know who has received what.",
        },
    ),
    Question(
        "Why did the cell with `session.run(Hello)` end although the node runs on?",
        (
            "A thread in the background runs the node.",
            "The node waits until the next cell runs.",
            "The node ended, too.",
        ),
        "a",
        "The session's thread runs the node, so that the notebook stays free.",
        {
            "b": "the node counted while you were reading.",
            "c": "who published the greetings that the log received afterwards?",
        },
    ),
)

PREDICTIONS = {
    "message_time": Prediction(
        ("How long does a message take from one program to another on the same machine?"),
        ("about a second", "about a tenth of a second", "less than a millisecond"),
        "c",
        "The line about the message gives the time: it is less than a millisecond on most machines.",
    ),
    "unknown_sender": Prediction(
        "Will the log receive it, although we never told the log who publishes?",
        (
            "no: it must know who publishes",
            "yes: the name and the type of the topic are enough",
            "only if it is told to wait for you",
        ),
        "b",
        "It will: the topic's name and type are all that the two sides share.",
    ),
    "node_after_cell": Prediction(
        "The next cell ends at once. Does the node end with it?",
        (
            "no: it goes on in the background",
            "yes: what a cell has started ends with the cell",
            "it stops, and goes on when the next cell runs",
        ),
        "a",
        "No: the node keeps publishing in the background while you read this.",
    ),
}
RECEIVE_TIMEOUT = 1.0  # s, for a message that was published just before
EVERY_NODES_TOPICS = {"/rosout", "/parameter_events"}


@exercise
def my_words(function: Any, log: TopicLog) -> str:
    """Check that `function` returns a sentence of at least three words, and that `log` has received it.

    Args:
        function: takes nothing, returns the sentence.
        log: a log of the topic on which the sentence was published (std_msgs/String).

    Raises:
        CheckError: if it does not, or was not received.
    """
    words = answer_of(function, call="my_words()")
    if words is None:
        raise CheckError(
            "my_words() returns a text", "None", "write return before the sentence: print only shows it."
        )
    if not isinstance(words, str):
        raise CheckError("my_words() returns a text", repr(words), "put your sentence in quotes.")
    if len(words.split()) < 3:
        raise CheckError("at least three words", repr(words), "write a longer sentence.")
    if not isinstance(log, TopicLog) or log.type_name != type_name(String):
        raise CheckError("a log of /hello", repr(log), 'give what session.log("/hello", String) returned.')
    try:
        log.wait_until(lambda message: message.data == words, RECEIVE_TIMEOUT)
    except TimeoutError as error:
        raise CheckError(f"{words!r} on {log.topic}", *_instead(function, log, str(error))) from None
    return f"Right: your words were sent over {log.topic}, and received."


quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def _instead(function: Any, log: TopicLog, silence: str) -> tuple[str, str]:
    """Return what was received instead of the sentence, and a hint."""
    session = LabSession.current()
    if session is None:
        return "no session is open", "run the cells of this lesson again, from `session = LabSession()` on."
    received = [sample.message.data for sample in log.samples()]
    found = f"the last message there is {received[-1]!r}" if received else silence
    if str(function) in received:
        return found, "this is the function itself: call it, my_words(), with parentheses."
    if received and function.__name__ in received[-1]:
        return (
            found,
            f'that is its name as a text: leave out the quotes, session.publish("{log.topic}", my_words()).',
        )
    topics = {publisher.topic_name for publisher in session.node.publishers} - EVERY_NODES_TOPICS
    if topics - {log.topic}:
        return found, f"you published on {', '.join(sorted(topics))}: the log has subscribed to {log.topic}."
    return found, f'publish what the function returns now: session.publish("{log.topic}", my_words()).'
