"""Campaign: does an uncertainty hold what it says, and does a test notice when a term of it is wrong."""
