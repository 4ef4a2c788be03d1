"""The folders of the control panel: one file each."""
