import {createHash} from 'node:crypto';
import {readFileSync} from 'node:fs';
import {defineConfig, type Plugin} from 'vite';

const sha = (text: string): string => `'sha256-${createHash('sha256').update(text, 'utf8').digest('base64')}'`;

/** One file without any request: script and style go into the page, which allows them by hash and nothing else. The
    script stands at the page's end, a classic one: a bundle without imports needs no more. */
function onePage(): Plugin {
  return {
    name: 'one-page',
    enforce: 'post',
    generateBundle(_, bundle) {
      let script = '', style = '';
      for (const [file, part] of Object.entries(bundle)) {
        if (part.type === 'chunk') script += part.code;
        else if (file.endsWith('.css')) style += String(part.source);
        if (!file.endsWith('.html')) delete bundle[file];
      }
      script = script.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--').replaceAll('\r\n', '\n');
      style = style.replaceAll('\r\n', '\n');
      const policy = `default-src 'none'; script-src ${sha(script)}; style-src ${sha(style)}; img-src data: blob:; ` +
        `base-uri 'none'; form-action 'none'`;
      const licence = readFileSync('node_modules/three/LICENSE', 'utf8').trim();  // of what the script holds
      const html = Object.values(bundle).find((part) => part.fileName.endsWith('.html'));
      if (html?.type !== 'asset') throw new Error('no page was built');
      html.source = String(html.source)
        .replace(/\s*<script type="module"[^>]*><\/script>/, '')
        .replace(/\s*<link rel="(stylesheet|modulepreload)"[^>]*>/g, '')
        .replace('<meta charset="utf-8">', (meta) =>
          `${meta}\n<meta http-equiv="Content-Security-Policy" content="${policy}">`)
        .replace('</head>', () => `<!-- three.js: ${licence} -->\n<style>${style}</style>\n</head>`)
        .replace('</body>', () => `<script>${script}</script>\n</body>`);
      html.fileName = 'page.html';
    },
  };
}

export default defineConfig({
  plugins: [onePage()],
  build: {
    target: 'es2022',
    modulePreload: false,
    cssCodeSplit: false,
    assetsInlineLimit: 1 << 24,
    rollupOptions: {input: 'page.html', output: {format: 'iife'}},
  },
});
