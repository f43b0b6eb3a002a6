"""The judged field: other people's block codes on the problems of the suite, and what each of them makes of each."""
