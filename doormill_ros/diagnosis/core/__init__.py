"""One verdict for every kind of data: problem, search, examination, ties, words and document."""
