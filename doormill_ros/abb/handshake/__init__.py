"""The handshake with the controller: request, clear, write, verify, ready, acknowledged, done."""
