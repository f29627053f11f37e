"""The fault campaign: does the rig stay safe, whatever breaks, whenever it breaks?"""
