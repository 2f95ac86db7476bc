"""What is the robot? Joints, points, boundaries as data; frames; robot files."""
