"""Recordings of robots (ROS 1 and ROS 2 bags): the maps, poses, images and scans that are in them."""
