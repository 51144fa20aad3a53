"""How Sphinx builds the book: `make book` calls it on the folder that build.py prepares."""

project = "nurbs_lab"
author = "the nurbs_lab maintainers"
html_title = "nurbs_lab"
language = "en"

extensions = ["myst_nb"]
nb_execution_mode = "off"  # the stored outputs are the book's
nb_render_markdown_format = "myst"  # tables and equations in the outputs of cells
myst_enable_extensions = ["dollarmath", "amsmath", "html_image"]
myst_heading_anchors = 3
mathjax_path = "mathjax/tex-chtml.js"  # copied by build.py: nothing is fetched from a network

html_theme = "sphinx_book_theme"
html_theme_options = {"show_navbar_depth": 1, "navbar_persistent": [], "use_download_button": False}
html_static_path = ["_static"]
html_favicon = "_static/favicon.svg"
html_js_files = ["viewer.js", "dragging.js"]
html_css_files = ["book.css"]
html_copy_source = False
html_show_sourcelink = False
html_context = {"default_mode": "auto"}  # dark or light as the reader's system has it
