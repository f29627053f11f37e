"""What a service and its screens need of a wheel on a belt: tables, hands, what past runs left on the rig."""
