"""What everything else rests on: values, actions, pictures, geometry, protocols. numpy alone."""
