"""The fault campaign: does the rig stay safe, no matter what breaks and when?"""
