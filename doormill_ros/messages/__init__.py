"""What messages say, read by the names of their fields: the same for a node's messages and a bag's.

Nothing here needs ROS. The way back, domain types to messages, needs the generated classes and stands in nodes/convert.
"""
