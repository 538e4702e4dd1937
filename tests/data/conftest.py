"""The sample project is run by a test of the plugin, as a project of its own."""

collect_ignore = ["sample_project"]
