function [words, options, settings] = option_words(who, known, pairs, folder)
%OPTION_WORDS  The options and settings of a call as words of the command line.
%   PAIRS are {NAME, VALUE, ...} of the function WHO. A name with a dot is a key of the scene. A row of KNOWN is an option: its
%   name, the program's, and the way of its value: 'one', 'joined' by commas, 'each' with the option before it, 'file' of
%   points in FOLDER, 'none' where it is not the program's. `settings` are the pairs that set keys.
options = struct();
settings = {};
words = {};
scene_keys = {'a key of the scene, as chain.preload_n'};
if any(strcmp(known(:, 2), '--connect'))
    scene_keys = {};  % a stream has its own scene
end
if mod(numel(pairs), 2)
    error('hertzline:wrongUse', '%s: found %d arguments behind the first ones, allowed: pairs of a name and a value', who, ...
          numel(pairs));
end
for k = 1:2:numel(pairs)
    name = pairs{k};
    value = pairs{k + 1};
    if ~ischar(name) && ~(isa(name, 'string') && isscalar(name))
        error('hertzline:wrongUse', '%s: found a %s, allowed: the name of a key or an option', who, class(name));
    end
    name = char(name);
    row = find(strcmp(known(:, 1), name));
    if any(name == '.') && ~isempty(scene_keys)
        name = program_key(name);
        settings(end + 1 : end + 2) = {name, value};
        words = [words, {'--set', setting(name, value)}]; %#ok<AGROW>
    elseif isempty(row)
        error('hertzline:wrongUse', '%s: found the option "%s", allowed: %s', who, name, ...
              strjoin([known(:, 1)', scene_keys], ', '));
    else
        options.(name) = value;
        words = [words, words_of(known{row, 2}, known{row, 3}, name, value, folder)]; %#ok<AGROW>
    end
end
end

function word = setting(key, value)
depth = list_depth(key);
if isempty(value) && ~ischar(value) && depth == 0
    word = [key '=null'];  % takes the value back
    return
end
word = [key '=' toml_value(key, value, depth)];
if numel(word) > 100000  % the system takes words of 128 KiB
    error('hertzline:wrongUse', '%s: found %d entries, allowed: as many in a struct of hertzline_scene', key, numel(value));
end
end

function words = words_of(flag, way, name, value, folder)
if strcmp(way, 'file')
    words = {flag, points_file(name, value, folder)};
    return
end
texts = texts_of(name, value);
switch way
    case 'none'
        words = {};
    case 'joined'
        words = {flag, strjoin(texts, ',')};
    otherwise
        if strcmp(way, 'one') && numel(texts) ~= 1
            error('hertzline:wrongUse', '%s: found %d values, allowed: one', name, numel(texts));
        end
        words = reshape([repmat({flag}, 1, numel(texts)); texts], 1, []);
end
end

function file = points_file(name, points, folder)
% Writes a CSV: a line of keys, then a line for each point.
columns = {};
points = reshape(points, 1, []);
for k = 1:2:numel(points) - 1
    columns{end + 1} = texts_of(char(points{k}), points{k + 1}); %#ok<AGROW>
end
lengths = cellfun(@numel, columns);
if isempty(columns) || mod(numel(points), 2) || any(lengths ~= lengths(1))
    error('hertzline:wrongUse', '%s: found %d entries with columns of %s values, allowed: {KEY, VALUES, ...}, equally many values each', ...
          name, numel(points), strjoin(cellfun(@number_text, num2cell(lengths), 'UniformOutput', false), ', '));
end
keys = cellfun(@program_key, points(1:2:end), 'UniformOutput', false);
rows = [keys; vertcat(columns{:})'];
file = fullfile(folder, 'points.csv');
lines = cell(size(rows, 1), 1);
for k = 1:size(rows, 1)
    lines{k} = strjoin(rows(k, :), ',');
end
write_text(file, sprintf('%s\n', lines{:}));
end
