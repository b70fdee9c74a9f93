"""``python -m mocapress``."""

from mocapress.cli import main

if __name__ == "__main__":
    main()
