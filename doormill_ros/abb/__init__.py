"""The ABB side: target files, RAPID, transports and the handshake with the controller."""
