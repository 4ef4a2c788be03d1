"""Questions of the lesson that are answered by doing: what the page looks at to tell whether it was done."""
