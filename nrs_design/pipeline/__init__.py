"""The one place that knows every stage: spec, plant, design, switched system, certificate."""
