// Elements of the page and numbers as text.

function element(tag, properties = {}, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

function signed(value, digits) {
  return value.toFixed(digits).replace('-', '−');
}
