"""Tell a diagnosis: document, page and what is known of a remainder."""
