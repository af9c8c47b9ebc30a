// Says what of the report does not show at this width.
addEventListener('load', () => {
  const wrong = [];
  const must = (right, what) => { if (!right) wrong.push(what); };
  const size = element => element.getBoundingClientRect();
  const sections = [...document.querySelectorAll('main > section')];
  must(sections.length > 1, 'no experiment');
  for (const section of sections) {
    must(section.querySelector('h2')?.textContent.trim(), `section ${section.id} has no title`);
    must(size(section).height > 150, `section ${section.id} is empty`);
    must(document.querySelector(`nav a[href="#${section.id}"]`), `section ${section.id} is not in the contents`);
  }
  for (const link of document.querySelectorAll('a[href^="#"]')) {
    must(document.getElementById(link.hash.slice(1)), `${link.hash} leads nowhere`);
  }
  must(document.images.length > 0, 'no figure');
  for (const image of document.images) {
    must(image.complete && image.naturalWidth > 0, `figure does not load: ${image.alt}`);
    must(size(image).width > 100 && size(image).height > 50, `figure does not show: ${image.alt}`);
    must(image.alt.trim(), 'a figure has no text');
  }
  for (const table of document.querySelectorAll('table')) {
    must(table.querySelectorAll('tbody tr').length > 0, 'a table has no rows');
  }
  for (const outcome of document.querySelectorAll('.claims tbody tr')) {
    must(outcome.querySelector('.outcome')?.textContent.trim(), 'a claim has no verdict');
  }
  const width = document.documentElement.clientWidth;
  must(document.documentElement.scrollWidth <= width, `the page is wider than ${width} px`);
  for (const element of document.querySelectorAll('main *, nav *, header *')) {
    const isInBox = element.closest('.scroll, pre, thead') && !element.matches('.scroll, pre');
    must(isInBox || size(element).right <= width + 1, `<${element.localName}> is wider than the page`);
  }
  const counted = `${sections.length} sections, ${document.images.length} figures`;
  const result = wrong.length ? `wrong: ${[...new Set(wrong)].join('; ')}` : `good: ${counted}`;
  parent.postMessage(`${width} px: ${result}`, '*');
});
