// Tables and code that are wider than the page can be scrolled by keys.
addEventListener("load", () => {
  for (const wide of document.querySelectorAll(".md-typeset__scrollwrap, pre > code"))
    if (wide.scrollWidth > wide.clientWidth) wide.tabIndex = 0;
});
