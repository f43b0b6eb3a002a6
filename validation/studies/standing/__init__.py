"""What of several blocks stands and what falls, against limits in closed form."""
