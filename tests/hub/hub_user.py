"""A user of a JupyterHub: enters by the page of the login, as a browser does, and starts a server."""

from __future__ import annotations

import http.cookiejar
import json
import urllib.parse
import urllib.request
from typing import Any

from deadlines import DEADLINE


class HubUser:
    """Somebody who has entered a hub by name and password.

    Args:
        hub: the address of the hub, such as `http://127.0.0.1:8000`.
        name: the account.
        password: its password.

    Raises:
        urllib.error.HTTPError: if the hub does not let them in.
    """

    def __init__(self, hub: str, name: str, password: str) -> None:
        self.hub, self.name = hub, name
        self._cookies = http.cookiejar.CookieJar()
        self._browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(self._cookies))
        self._open("/hub/login")
        fields = {"username": name, "password": password, "_xsrf": self._xsrf}
        self._open("/hub/login?next=/hub/home", urllib.parse.urlencode(fields).encode())
        self.token: str = self.ask("POST", f"users/{name}/tokens", {"note": "a test"})["token"]

    @property
    def address(self) -> str:
        """Where this user's JupyterLab is, with a token."""
        return f"{self.hub}/user/{self.name}/lab?token={self.token}"

    def start(self) -> None:
        """Start this user's server where it does not run yet, and wait until it answers.

        Raises:
            AssertionError: if it does not.
        """
        if not self.ask("GET", f"users/{self.name}")["servers"]:
            self.ask("POST", f"users/{self.name}/server")
        told = []
        with self._open(f"/hub/api/users/{self.name}/server/progress") as events:
            for line in events:
                if line.startswith(b"data:"):
                    told.append(json.loads(line.removeprefix(b"data:")))
        assert told[-1].get("ready"), f"{self.name}'s server did not start: {told}"

    def first_page(self) -> str:
        """Open this user's JupyterLab in the browser, and return the path of the page that is shown."""
        with self._open(f"/user/{self.name}/") as answer:
            return urllib.parse.urlsplit(answer.url).path

    def stop(self) -> None:
        """Stop this user's server."""
        self.ask("DELETE", f"users/{self.name}/server")

    def ask(self, method: str, place: str, content: Any = None) -> Any:
        """Ask the hub's REST API, and return its answer."""
        data = None if content is None else json.dumps(content).encode()
        with self._open(f"/hub/api/{place}", data, method) as answer:
            body = answer.read()
        return json.loads(body) if body else None

    @property
    def _xsrf(self) -> str:
        found = (
            cookie.value for cookie in self._cookies if cookie.name == "_xsrf" and cookie.path == "/hub/"
        )
        return next(found) or ""

    def _open(
        self, path: str, data: bytes | None = None, method: str | None = None, timeout: float = DEADLINE
    ) -> Any:
        headers = {"X-XSRFToken": self._xsrf} if len(self._cookies) else {}
        if path.startswith("/hub/api/"):
            headers["Content-Type"] = "application/json"
        request = urllib.request.Request(self.hub + path, data, headers, method=method)
        return self._browser.open(request, timeout=timeout)
