"""An action server that can fall silent and speak again while its node goes on."""

from __future__ import annotations

from typing import Any

from rclpy.action import ActionServer


class QuietActionServer(ActionServer):  # type: ignore[misc]  # rclpy has no types
    """Leaves goals to another server of its name while it is `silent`.

    To destroy a server under a spinning executor ends that executor, and what it had to answer. One that is only told
    to refuse would answer beside the other one, and a client believes whichever is quicker.
    """

    silent = False

    async def execute(self, taken_data: Any) -> None:
        """Answer what came; nothing of a client's while silent."""
        if self.silent:
            taken_data = {key: value for key, value in taken_data.items() if key == "expired"}
        await super().execute(taken_data)

    def _send_result_response(self, *args: Any) -> None:
        if not self.silent:
            super()._send_result_response(*args)
