"""The generator of Talbot's built-in scenes; started by ../generate.py."""
