"""The exercise of `00_welcome`."""

from __future__ import annotations

from typing import Any

from std_msgs.msg import String

from ros2lab import every_node
from ros2lab.checks import CheckError, answer_of, exercise, predict_of, questions_of, quiz_of
from ros2lab.session import LabSession
from ros2lab.topics import TopicLog, type_name

RECEIVE_TIMEOUT = 1.0  # s, for a message that was published just before


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


QUIZ, PREDICTIONS = questions_of(__name__)
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
    topics = {publisher.topic_name for publisher in session.node.publishers} - every_node.TOPICS
    if topics - {log.topic}:
        return found, f"you published on {', '.join(sorted(topics))}: the log has subscribed to {log.topic}."
    return found, f'publish what the function returns now: session.publish("{log.topic}", my_words()).'
