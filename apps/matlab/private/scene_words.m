function [words, settings] = scene_words(who, known, scene, pairs, folder)
%SCENE_WORDS  The scene of a call, its settings and its options as words of the command line. See option_words.
if isstruct(scene) && isscalar(scene)
    file = fullfile(folder, 'scene.toml');
    write_text(file, toml_text(scene));
elseif ischar(scene) || (isa(scene, 'string') && isscalar(scene))
    file = char(scene);
else
    error('hertzline:wrongUse', '%s: found a scene of class %s, allowed: the name of a shipped scene, a file or a struct', who, ...
          class(scene));
end
[words, ~, settings] = option_words(who, known, pairs, folder);
words = [{file}, words];
end

function text = toml_text(scene)
sections = fieldnames(scene);
tables = cell(1, numel(sections));
for k = 1:numel(sections)
    name = program_key(sections{k});
    values = scene.(sections{k});
    if strcmp(name, 'drive') && isfield(values, 'file') && ~isempty(values.file)
        values.file = absolute(values.file);  % a scene looks for it in its own folder
    end
    tables{k} = toml_table(name, values);
end
text = [tables{:}];
end

function text = toml_table(name, values)
% A table without keys that are not given; tables within it follow.
if ~isstruct(values) || ~isscalar(values)
    error('hertzline:wrongUse', '%s: found a %s, allowed: a struct of the keys of this section', name, class(values));
end
keys = fieldnames(values);
lines = sprintf('[%s]\n', name);
inner = '';
for k = 1:numel(keys)
    key = [name '.' keys{k}];
    value = values.(keys{k});
    if isstruct(value)
        inner = [inner, toml_table(key, value)]; %#ok<AGROW>
    elseif ~isempty(value)
        lines = [lines, sprintf('%s = %s\n', keys{k}, toml_value(key, value, list_depth(key)))]; %#ok<AGROW>
    end
end
text = [lines, inner];
end

function file = absolute(file)
file = char(file);
if file(1) ~= '/'
    file = fullfile(pwd, file);
end
end
