"""The docs as plain Markdown, installed as `mpm_docs`. `mpm docs` says where they are and prints a page."""
