"""The damping that a scene really has, what to choose instead, and alarms, from closed forms and finished rows."""
