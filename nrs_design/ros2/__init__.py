"""Parameter files of ros2_controllers: what a user already runs, held against its environment."""
