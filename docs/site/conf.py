"""Settings of the documentation site; `make docs` assembles what it is built from."""

from importlib import metadata

project = "truebreak"
author = "the truebreak authors"
release = version = metadata.version("truebreak")

extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
root_doc = "index"
myst_heading_anchors = 4
myst_all_links_external = False
smartquotes = False  # a prime is no quotation mark
html_theme = "furo"
html_title = f"truebreak {version}"
html_show_copyright = False
html_static_path = ["static"]
html_css_files = ["site.css"]
html_extra_path = ["extra"]
html_theme_options = {"navigation_with_keys": True}
html_copy_source = False
html_show_sourcelink = False
maximum_signature_line_length = 88
toc_object_entries_show_parents = "hide"
