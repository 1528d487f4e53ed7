"""The range sensor model beside recordings of a real sensor."""
