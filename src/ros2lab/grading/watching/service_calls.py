"""Make requests to the services in a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from ros2lab.assignments import Part
from ros2lab.grading.watching.watch import Watch

REPEATED_CALLS = 3


def call_services(
    watch: Watch, services: Iterable[Part], answered: dict[str, int], is_whole: Callable[[], bool]
) -> Iterator[dict[str, Any]]:
    """Make the assignment's requests, and the first one again, to see that the service goes on.

    Args:
        watch: the run's Watch.
        services: the services of the assignment.
        answered: by topic, after how many requests a message came; counts are added here.
        is_whole: returns whether no program has ended.

    Yields:
        What followed each request.

    Raises:
        Gone: if all programs have ended.
    """
    for part in services:
        name = watch.service(part)
        requests = [exchange.request for exchange in part.requests] or [{}]
        again = requests[:1] * REPEATED_CALLS
        for number, request in enumerate([*requests, *again] if name else []):
            totals = {topic: watch.ears[topic].total for topic in answered}
            response, took = watch.call(part, name, request)
            if response is not None:  # wait for what follows it
                watch.settle(watch.patience)
            for topic, total in totals.items():
                answered[topic] += watch.ears[topic].total > total
            yield {
                "service": name,
                "request": dict(request),
                "response": response,
                "seconds": took,
                "is_repeated": number >= len(requests),
                "is_alive": is_whole(),
                "topics": watch.part(),
            }
            if response is None and number >= len(requests):
                break
            watch.check()
